"""The runtime of exported models, in Python that is printed as C and as Java.

What the modules here may say is in `hybond.export.translate`; they are ordinary Python too, and
are run as such by the tests.
"""
