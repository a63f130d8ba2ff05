"""Bifurcation diagrams: what a model comes to, value after value of a parameter.

`call` is `hybond.bifurcation`; `question` is what it asks, `values` runs it by the library and
`ordinary` without, `orbits` tells periods, `record` is what comes out, `windows` where it changes.
"""
