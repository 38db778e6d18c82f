"""From logs of the built robot to its parameters, and the motions that show them."""
