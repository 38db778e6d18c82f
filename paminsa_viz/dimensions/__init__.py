"""What the bodies measure and where they are: read by what draws them and by what checks them.

`layers` holds the sizes of a leg's bodies and of the machine's fixed parts, `layout` the heights
of the frame, `attached` the sizes of payload and counterweights, `placement` where every body is
in a configuration. Lengths in meters.
"""
