"""The optimise room: it makes cases, runs them, and learns from their figures. It stands above the line of `run`."""
