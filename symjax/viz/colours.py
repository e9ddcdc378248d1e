"""The colours of all pictures, as red, green and blue from 0 to 255."""

Rgb = tuple[int, int, int]

CLOUD = (58, 118, 196)
MIRRORED = (238, 136, 44)
PLANE = (38, 158, 140)
PAIR = (196, 32, 66)
REJECTED = (150, 156, 166)
REMOVED = (206, 210, 217)
INK = (31, 41, 55)
FAINT_INK = (107, 114, 128)


def css(colour: Rgb, brightness: float = 1.0) -> str:
    """Formats a colour as CSS, scaled by `brightness`."""
    return "rgb({}, {}, {})".format(*(round(brightness * channel) for channel in colour))
