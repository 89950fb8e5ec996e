"""What can be found out about a run or a fixture before anything is computed."""

from erlif.review.audit.directory import Audit, audit, check

__all__ = ["Audit", "audit", "check"]
