"""Everything that relies on a non-public name of viser, plotly or Mantine."""
