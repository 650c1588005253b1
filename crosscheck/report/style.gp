# The looks of every dynwitness chart. Set dark = 1 before loading this to draw for a dark page.
if (!exists("dark")) { dark = 0 }

# Okabe and Ito, "Color Universal Design" (2008): told apart by colour-blind readers. Marker and dash
# differ too, so that no curve is known by its colour alone.
ink = dark ? '#e7eaee' : '#1d2430'
soft = dark ? '#a3adba' : '#5b6675'
faint = dark ? '#3a4453' : '#d9dee5'
blue = dark ? '#56b4e9' : '#0072b2'
orange = dark ? '#f0904f' : '#d55e00'
green = dark ? '#2cc89a' : '#009e73'
purple = dark ? '#e29ac4' : '#b0568c'
amber = dark ? '#f0c042' : '#c98800'
sky = dark ? '#8ab6ff' : '#4a9fd0'

# How a picture is written (svg, png, pdf) and on what (white, or paper as dark as the page, and transparent); without
# a word svg and pdf are on nothing and png is on white. Set both before loading this.
if (!exists("picture")) { picture = 'svg' }
if (!exists("paper")) { paper = '' }
sheet = paper eq 'white' || (paper eq '' && picture eq 'png') \
  ? sprintf("background rgb '%s'", dark ? '#11151b' : '#ffffff') : picture eq 'png' ? 'transparent' : ''
# w x h points of a hundredth of an inch, letters of so many points; png has two pixels a point
canvas(w, h, letters) = picture eq 'png' \
  ? sprintf("set terminal pngcairo size %d,%d noenhanced font 'Liberation Sans,%g' fontscale 1.5 linewidth 2 pointscale 2 dashlength 3 rounded %s", 2*w, 2*h, letters, sheet) \
  : picture eq 'pdf' \
  ? sprintf("set terminal pdfcairo size %gin,%gin noenhanced font 'Liberation Sans,%g' fontscale 0.66 linewidth 0.72 pointscale 0.72 dashlength 3 rounded %s", w / 100.0, h / 100.0, letters, sheet) \
  : sprintf("set terminal svg size %d,%d fixed noenhanced font 'Liberation Sans,Arial,Helvetica,sans-serif,%g' rounded linewidth 1 %s", w, h, letters, sheet)
picture_file(stem) = stem.(dark ? '_dark' : '').'.'.picture
eval canvas(1000, 400, 13)
set encoding utf8
set datafile separator ','

set linetype 1 linecolor rgb blue   linewidth 2 dashtype 1       pointtype 7 pointsize 0.8
set linetype 2 linecolor rgb orange linewidth 2 dashtype (12,3)  pointtype 5 pointsize 0.7
set linetype 3 linecolor rgb green  linewidth 2 dashtype (6,3)   pointtype 9 pointsize 0.9
set linetype 4 linecolor rgb purple linewidth 2 dashtype (2,3)   pointtype 11 pointsize 0.9
set linetype 5 linecolor rgb amber  linewidth 2 dashtype (12,3,2,3) pointtype 13 pointsize 0.9
set linetype 6 linecolor rgb sky    linewidth 2 dashtype (6,3,2,3)  pointtype 6 pointsize 0.8
set linetype 7 linecolor rgb blue   linewidth 2 dashtype (2,3)  pointtype 10 pointsize 1.0   # fast sweeps
set linetype 8 linecolor rgb sky    linewidth 2 dashtype (2,3)  pointtype 2  pointsize 1.0   # the kernel in lanes
set linetype cycle 6
# outside engines: hollow markers, and none has the shape of ours in the same colour
set linetype 11 linecolor rgb sky    linewidth 2 dashtype 1 pointtype 14 pointsize 1.0   # simbody
set linetype 12 linecolor rgb orange linewidth 2 dashtype 1 pointtype 8  pointsize 1.0   # mujoco_principal
set linetype 13 linecolor rgb green  linewidth 2 dashtype 1 pointtype 12 pointsize 1.1   # dart
set linetype 14 linecolor rgb purple linewidth 2 dashtype 1 pointtype 6  pointsize 1.0   # kdl
set linetype 15 linecolor rgb amber  linewidth 2 dashtype 1 pointtype 4  pointsize 0.9   # mujoco
set linetype 16 linecolor rgb ink    linewidth 2 dashtype 1 pointtype 3  pointsize 0.9   # any other
set linetype 20 linecolor rgb soft linewidth 1.3 dashtype (4,4)   # guides

set border 3 linecolor rgb soft
set tics nomirror textcolor rgb soft
set grid linecolor rgb faint linewidth 0.8 dashtype 1
set title textcolor rgb ink
set xlabel textcolor rgb ink
set ylabel textcolor rgb ink
set key textcolor rgb ink
set key samplen 3 spacing 1.15
