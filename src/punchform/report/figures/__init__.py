"""The figures of a formed grid, one file of code each; `gallery` lists them."""
