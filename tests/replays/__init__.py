"""Replays of reference outputs through the public API, one module a family.

`recognises(document)` tells a file outside the family's folder by what stands in it, `replay(path, document)` answers it.
"""
