"""Words of the messages of errors."""

_WORDS = """
    add calibrate call change check choose clean close compare convert copy correct cover
    delete divide draw exchange export give install keep lay leave log lower make measure
    mount move name number open pass photograph pick point press put raise read record reduce
    register reload remove rename repeat replace run save set show start take try use wait
    widen write
"""

STEPS = frozenset(_WORDS.split())
"""Words with which a sentence begins that names the next step."""
