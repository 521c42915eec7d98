# numerics: errors of hard cases in units of their bounds. `cases` has a row per case: row of the topic, ratio of tactnet, ratio of
# a naive implementation, a number to spread the points by. `topics` are their names with slashes between them, `caption` says
# what was measured. No error stands at `none`, what is infinite or not a number at `lost`.
load "style.gnuplot"
eval begin("numerics", 640, 480)
none = 1e-14
lost = 1e18
last = 0
rest = topics
while (strlen(rest) > 0) {
    end = strstrt(rest, "/")
    set ytics add (rest[1:end - 1] last) scale 0
    rest = rest[end + 1:*]
    last = last + 1
}
set logscale x
set xrange [none / 30:lost * 30]
set xtics ("0" none, "10⁻⁸" 1e-8, "10⁻⁴" 1e-4, "1" 1, "10⁴" 1e4, "10⁸" 1e8, "10¹²" 1e12, "∞, NaN" lost)
set yrange [last - 0.4:-1.2]
set xlabel "error ÷ bound (log scale)"
set border 1
set lmargin 23
set rmargin 5
set tmargin 0.5
set bmargin 5
unset key
set arrow 1 from 1,graph 0 to 1,graph 1 nohead lc rgb ink dt (6,4)
set label 1 "tactnet" at 1,-0.75 right offset -1,0 tc rgb blue
set label 2 "naive implementation" at 1,-0.75 left offset 1,0 tc rgb orange
eval note(caption)
plot cases using 3:($1 + 0.17 + $4) with points pt 2 ps 0.45 lw 1.5 lc rgb orange, \
    "" using 2:($1 - 0.17 + $4) with points pt 7 ps 0.45 lc rgb blue
