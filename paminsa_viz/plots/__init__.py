"""Figures: results in, pictures out, for the screen (plotly, small rasters) and for files.

`maps.MapData` is the one data object that all of them read. `scale` decides the colors, `screen`
and `live` draw for the page, `paper` draws for print. Nothing is imported here, so that the page
does not pay for matplotlib before somebody asks for a file.
"""
