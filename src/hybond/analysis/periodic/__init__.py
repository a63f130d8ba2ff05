"""Motions that repeat: found by shooting, with Floquet multipliers, followed along a parameter.

One unknown serves all: the state x at the beginning of a period. A shot runs the model over a
period from there, F(x) = x(T; x), and the variations beside it, M = dF/dx.

    shots         one period run, with its end and its derivatives
    periods       how long a period is: what is asked, what the model repeats with, what a run does
    newton        x with F(x) = x: Newton's steps, shorter ones, and periods run on
    multipliers   the eigenvalues of M, and which of them tell of stability: `lost` says how many
                  are zero for structure, `still` whether nothing damps a pair, `resting` which
                  variations there are where a contact rests
    periodic      `periodic`: the public function; `orbit` its record
    continuation  `continuation`: along a parameter; `arc` its steps, `points` what is passed there
"""
