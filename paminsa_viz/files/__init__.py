"""Reading and writing files: designs as TOML, tables of poses as CSV.

Nothing here computes a robot; these modules turn text into the model's types and back, and name
the file, the line or row, and the key or column of whatever they refuse.
"""
