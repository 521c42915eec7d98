# Makes touches.png, the first picture of the README: the first simulated touch in eight strips of objects/, which
# tactnet_touches draws. Run in docs/pictures/: gnuplot touches.gnuplot
set terminal pngcairo size 880,300 font "DejaVu Sans,11"
set output "touches.png"
set multiplot layout 2,4 margins 0.01,0.99,0.02,0.93 spacing 0.015,0.11
unset key
unset tics
unset border
set size ratio -1
set title offset 0,-0.7
do for [strip in "tools/pliers tools/scissors tools/key tools/sticky_tape solids/rubber bars/allen_key bars/can bars/cable"] {
    name = strip[strstrt(strip, "/") + 1:]
    set title (name eq "sticky_tape" ? "sticky tape" : name eq "allen_key" ? "Allen key" : name)
    # A strip is 872 × 72: eight pictures of 100 × 56, 8 apart; rows count from the bottom.
    set xrange [440:539]
    set yrange [8:63]
    plot "objects/".strip.".png" binary filetype=png with rgbimage
}
unset multiplot
