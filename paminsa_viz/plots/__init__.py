"""Figures: results in, figures out, for the page, notebooks and files.

Maps: `map_data.MapData` is what all of them read, `ranges` and `scale` decide the colors,
`contours` the lines, `map_layout` the places. `map_figure` draws for the page and for print,
`interactive` for notebooks; `hover` is what the pointer reads. `formats` is the registry of file
formats. Nothing is imported here, so that nobody waits for matplotlib who does not draw.
"""
