"""The studio: a page in the browser or in a notebook in which bond graphs are drawn and run.

`session` speaks in plain messages and knows no web; `server` and `widget` carry them to a page.
What the page shows is made of the text of a model file, which alone is kept: `document` holds it,
`edits` change it, `view`, `strokes` and `problems` say what it means, `runs` simulates it.
"""
