# Test accuracy against the number of training images.
set xlabel "training images"
