"""Figures: results in, figures out, for the page, notebooks and files.

Maps: all read `map_data.MapData`; `ranges` and `scale` decide the colors,
`contours` the lines, `map_layout` the places. `map_figure` draws for the page and for print,
`interactive` for notebooks; `hover` shows values at the pointer. `formats` is the registry of file
formats. Nothing is imported here, since matplotlib is slow to import.
"""
