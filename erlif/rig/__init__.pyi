from .directory import simulate as simulate
from .endurance import EnduranceRig as EnduranceRig
from .endurance import EnduranceTruth as EnduranceTruth
from .endurance import simulate_endurance as simulate_endurance
from .endurance import write_endurance_log as write_endurance_log
from .settings import DyeSpectra as DyeSpectra
from .settings import RigSettings as RigSettings
