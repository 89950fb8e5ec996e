"""Words of the messages of errors."""

STEPS = frozenset(
    (
        *(
            "add",
            "calibrate",
            "call",
            "change",
            "check",
            "choose",
            "close",
            "compare",
            "convert",
            "copy",
        ),
        *("correct", "cover", "delete", "divide", "exchange", "export", "give", "install", "keep"),
        *("leave", "log", "make", "measure", "mount", "move", "name", "number", "pass", "pick"),
        *("photograph", "put", "raise", "record", "register", "remove", "rename", "repeat"),
        *("replace", "save", "set", "show", "start", "take", "try", "use", "wait", "widen"),
        *("draw", "reload"),
        *("write", "clean", "press", "point", "lay", "reduce", "lower", "run", "point", "read"),
    )
)
"""Words with which a sentence begins that names the next step."""
