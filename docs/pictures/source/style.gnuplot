# The one style of all charts. Before it is loaded, `folder` is where pictures go.
#
# Colours are Okabe and Ito's (2008), which deuteranopes and protanopes tell apart; svg.py says what they become on a dark
# ground. Pictures are at most 640 wide, so that their words can be read at the width of a telephone.
ink = 0x24292f
quiet = 0x59636e
rule = 0xd8dee4
blue = 0x0072b2
orange = 0xd55e00
green = 0x009e73
purple = 0xa8508a

# begin(name, width, height): draws until the next into folder/name.svg.
begin(name, width, height) = sprintf("set terminal svg size %d,%d font 'sans-serif,15' noenhanced; set output '%s/%s.svg'", \
    width, height, folder, name)
# Small print under the picture: what was measured, and on which processor.
note(text) = sprintf("set label 99 \"%s\" at screen 0.5,0 center offset 0,0.75 tc rgb quiet font ',12.5'", text)

set datafile separator ","
set encoding utf8
set border 3 lc rgb quiet
set tics nomirror tc rgb ink
set xlabel tc rgb ink
set ylabel tc rgb ink
set title tc rgb ink
set key tc rgb ink reverse Left samplen 1.6
set grid lc rgb rule lw 1 dt solid
set style fill solid noborder
