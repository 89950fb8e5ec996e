from .design import DesignSettings as DesignSettings
from .design import LockOfJoint as LockOfJoint
from .design import PartOfJoint as PartOfJoint
from .design import read_design_settings as read_design_settings
from .endurance import EnduranceSettings as EnduranceSettings
from .endurance import read_endurance_settings as read_endurance_settings
