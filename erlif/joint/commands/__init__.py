"""The commands of the joint; `erlif.commands.main` finds them by their names."""
