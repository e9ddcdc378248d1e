"""The robust method: how often it is right, what each stage is good for, and whether its thresholds and errors hold."""
