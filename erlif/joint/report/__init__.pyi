from .design import list_materials as list_materials
from .design import summarise_design as summarise_design
from .design_page import make_design_page as make_design_page
from .design_page import write_design_page as write_design_page
from .design_page import write_design_table as write_design_table
from .linkage import summarise_linkages as summarise_linkages
