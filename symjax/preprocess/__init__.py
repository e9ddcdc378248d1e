"""From given points to a cloud: checked, in a frame and units of its own, outliers and ground left out, thinned."""
