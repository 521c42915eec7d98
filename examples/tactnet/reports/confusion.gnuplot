# A confusion matrix: shares of the true class in colour, counts in figures.
set border 31 lt black
unset grid
side = 260 + 34 * n
eval terminal(sprintf("%d,%d", side + 60, side), "font ',12'")
array total[n]
do for [i = 1:n] {
    stats ARG1 skip 1 every ::(i - 1)::(i - 1) using (sum [j = 2:n + 1] column(j)) nooutput
    total[i] = STATS_max
}
share(truth, count) = total[int(truth) + 1] > 0 ? count / total[int(truth) + 1] : 0
set title ARG2
set xrange [-0.5:n - 0.5]
set yrange [n - 0.5:-0.5]
set xtics mirror rotate by 60 right ("" 0)
set ytics mirror ("" 0)
do for [i = 1:n] {
    set xtics add (name[i] i - 1)
    set ytics add (name[i] i - 1)
}
set xlabel "recognised class"
set ylabel "true class"
set size ratio 1
set cbrange [0:1]
set cbtics mirror
set palette defined (0 "white", 1 "dark-blue")
set cblabel "share of the true class"
unset key
plot ARG1 matrix skip 1 every 1::1 using ($1 - 1):2:(share($2, $3)) with image, \
    "" matrix skip 1 every 1::1 using ($1 - 1):2:($3 > 0 ? sprintf("%d", $3) : ""):(share($2, $3) > 0.5 ? 0xffffff : 0) \
    with labels textcolor rgb variable font ",8"
