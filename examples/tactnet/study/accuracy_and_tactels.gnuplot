# Test accuracy against the number of tactels, of methods at several sizes.
set xlabel "tactels"
