from .measures import grashof_class as grashof_class
