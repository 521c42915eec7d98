# The one style of all charts. Before it is loaded, `theme` is "light" or "dark" and `folder` is where pictures go.
#
# Colours are Okabe and Ito's (2008), which deuteranopes and protanopes tell apart; a dark ground takes their lighter ones.
# Pictures are at most 640 wide, so that their words can be read at the width of a telephone.
dark = theme eq "dark"
ink = dark ? 0xd6dce3 : 0x24292f
quiet = dark ? 0x9aa4af : 0x59636e
rule = dark ? 0x3a424c : 0xd8dee4
blue = dark ? 0x56b4e9 : 0x0072b2
orange = dark ? 0xe69f00 : 0xd55e00
green = dark ? 0x2fc597 : 0x009e73
purple = dark ? 0xcc79a7 : 0xa8508a

# begin(name, width, height): draws until the next into folder/name.svg, or folder/name_dark.svg.
begin(name, width, height) = sprintf("set terminal svg size %d,%d font 'sans-serif,15' noenhanced; set output '%s/%s%s.svg'", \
    width, height, folder, name, dark ? "_dark" : "")
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
