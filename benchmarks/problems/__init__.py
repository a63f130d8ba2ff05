"""The problems of the speed table, one a file: the model, the job in other tools, what is true."""
