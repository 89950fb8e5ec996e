from .directory import simulate as simulate
from .settings import DyeSpectra as DyeSpectra
from .settings import RigSettings as RigSettings
