#!/bin/sh
# Runs every operator on a material and puts it before and after the edit, lit from the left and from
# the right, side by side into docs/images/gallery/.
#   examples/gallery/gallery.sh path/to/normalshop path/to/models [folder for the results] [operator...]
# Needs ImageMagick's convert. docs/gallery.md says what the pictures show.
set -eu
program=$1
data=$2
work=${3:-$(mktemp -d)}
[ $# -gt 3 ] && shift 3 && only=" $* " || only=
here=$(cd "$(dirname "$0")" && pwd)
pictures=$here/../../docs/images/gallery
mkdir -p "$pictures" "$work"

# Runs the program; its words are shown only where it fails.
run() {
  "$program" "$@" > "$work/run.log" 2>&1 || { cat "$work/run.log"; exit 1; }
}

wanted() { # NAME
  [ -z "$only" ] || case $only in *" $1 "*) ;; *) return 1 ;; esac
}

shaded() { # NORMALS COLORS LIGHT PNG
  run shade "$1" ${2:+--color "$2"} --light="$3" -o "$4"
}

# figure NAME NORMALS COLORS CROP OPERATOR FLAG...: COLORS is a file, or - for none.
figure() {
  name=$1 normals=$2 colors=$3 crop=$4
  shift 4
  wanted "$name" || return 0
  [ "$colors" = - ] && colors=
  after=$work/$name.png after_colors=$colors
  if [ "$1" = warp ]; then
    after_colors=$work/$name-colors.png
    set -- "$@" --color "$colors" --color-output "$after_colors"
  fi
  operator=$1
  shift
  run "$operator" "$normals" "$@" --bits 16 -o "$after"
  echo "$name: $(grep changed "$work/run.log")"
  shaded "$normals" "$colors" -1,0.5,0.8 "$work/1.png"
  shaded "$after" "$after_colors" -1,0.5,0.8 "$work/2.png"
  shaded "$normals" "$colors" 1,0.5,0.8 "$work/3.png"
  shaded "$after" "$after_colors" 1,0.5,0.8 "$work/4.png"
  convert "$work/1.png" "$work/2.png" "$work/3.png" "$work/4.png" -gravity center -crop "$crop+0+0" +repage \
    -filter Lanczos -resize 320x320 -background white -gravity east -splice 4x0 +append -gravity east -chop 4x0 \
    -strip -quality 86 "$pictures/$name.jpg"
}

bark=$data/mat_ambientcg_bark
facade=$data/mat_ambientcg_facade
metal=$data/mat_ambientcg_metal
rock=$data/mat_ambientcg_rock
rust=$data/mat_ambientcg_rustymetal
wood=$data/mat_rosewood_veneer/rosewood_veneer1

printf '[[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]]\n' > "$work/row.json"
# What has something to balance, and what has curl.
run rotate "$bark/normal.jpg" --azimuth 90 --tilt 90 --angle 25 --bits 16 -o "$work/tilted.png"
run paint "$rock/normal.jpg" --azimuth 180 --tilt 40 --strength 0.6 --area brush --brush 160 \
  --stroke "-300,-220 0,220 300,-220" --bits 16 -o "$work/painted.png"

figure pen "$metal/normal.jpg" "$metal/albedo.jpg" 800x800 pen --profile crease --width 34 --height 12 --taper 120 \
  --stroke "-330,260 -120,120 60,-160 330,-240" --stroke "-260,-280 -40,-40 80,120 240,330,0.4"
figure trim "$metal/normal.jpg" - 960x960 trim --pattern "$bark/normal.jpg" --width 220 \
  --relief 2.5 --border 0.12 --stroke "-420,-300 -200,200 100,-150 420,330"
figure stamp "$metal/normal.jpg" "$metal/albedo.jpg" 800x800 stamp --patch "$rock/normal.jpg" --size 360 \
  --rotation 20 --border 0.3 --relief 1.5 --stroke "-190,170" --stroke "180,-150"
figure text "$wood"_nor_gl_1k.png "$wood"_diff_1k.jpg 800x800 text --text 'NORMAL\nSHOP' --size 150 --height=-14 \
  --bevel 14 --stroke "0,-20"
figure combine "$facade/normal.jpg" - 440x440 combine --image "$bark/normal.jpg" --size 300 \
  --repeat true --relief 0.7 --model rotation
figure smooth "$rock/normal.jpg" - 700x700 smooth --sigma 8 --edges wrap
figure sharpen "$rock/normal.jpg" - 700x700 sharpen --sigma 5 --noise_sigma 1 --amount 1.5 --edges wrap
figure filter "$rock/normal.jpg" - 700x700 filter --kind high_pass --sigma 12 --edges wrap
figure denoise "$rock/normal.jpg" - 500x500 denoise --sigma 4 --sigma_normal 0.25 --edges wrap
figure denoise-gain "$rock/normal.jpg" - 500x500 denoise --sigma 4 --sigma_normal 0.25 --gain 2.5 --edges wrap
figure convolve "$rock/normal.jpg" - 700x700 convolve --kernel "$work/row.json" --normalize true --edges wrap
figure equalize "$rock/normal.jpg" - 700x700 equalize --sigma 2 --gains "0,0.3,1,2.2,2.2" --edges wrap
figure transplant "$rock/normal.jpg" "$rock/albedo.jpg" 700x700 transplant --image "$rust/normal.jpg" --sigma 12 \
  --relief 25 --edges wrap
figure flatten "$rock/normal.jpg" - 900x900 flatten --area inside --feather 12 \
  --stroke "-260,-200 260,-200 260,200 -260,200"
figure paint "$rock/normal.jpg" - 900x900 paint --azimuth 180 --tilt 40 --strength 0.6 --area brush \
  --brush 160 --stroke "-300,-220 0,220 300,-220"
figure rotate "$rock/normal.jpg" - 900x900 rotate --azimuth 90 --tilt 90 --angle 25 --area inside \
  --feather 12 --stroke "-260,-200 260,-200 260,200 -260,200"
# A point each tile; their colours count.
figure segments "$facade/normal.jpg" - 440x440 paint --color "$facade/albedo.jpg" --area segments \
  --coarseness 2 --azimuth 200 --tilt 35 --strength 0.8 --edges wrap --stroke "-110,63" --stroke "-46,20" \
  --stroke "50,-22" --stroke "-14,-108" --stroke "114,106" --stroke "-78,-151" --stroke "82,-151" --stroke "146,-65"
figure balance "$work/tilted.png" - 700x700 balance
figure project "$work/painted.png" - 900x900 project --edges wrap
figure warp "$rock/normal.jpg" "$rock/albedo.jpg" 900x900 warp --kind twirl --radius 320 --amount 1.2 --stroke "0,0" --edges wrap

# A head as an RGBN image, drawn in every style.
if wanted styles; then
  head=$data/lee_perry_smith
  for style in normals albedo; do
    run render "$head/LeePerrySmith.glb" --flip-v --normal-map "$head/Infinite-Level_02_Tangent_SmoothUV.jpg" \
      --albedo "$head/Map-COL.jpg" --view=0.3,0.1,1 --resolution 1000x1000 --style $style -o "$work/head_$style.png"
  done
  # The middle code has no direction: nothing is there.
  convert "$work/head_normals.png" -colorspace HSL -channel G -separate -threshold 12% -morphology Open Disk:2 \
    -morphology Close Disk:25 "$work/head_mask.png"
  convert -size 1000x1000 'xc:rgb(128,128,128)' "$work/head_normals.png" "$work/head_mask.png" -composite "$work/head.png"
  run shade "$work/head.png" --color "$work/head_albedo.png" --light=-1,0.6,0.5 -o "$work/style_1.png"
  run shade "$work/head.png" --style toon --light=0.3,1,0.5 --edge-shadows 40 -o "$work/style_2.png"
  run shade "$work/head.png" --style lines -o "$work/style_3.png"
  run shade "$work/head.png" --style curvature -o "$work/style_4.png"
  run shade "$work/head.png" --style exaggerated -o "$work/style_5.png"
  convert "$work"/style_[1-5].png -crop 640x760+180+0 +repage -filter Lanczos -resize 256x304 +append -strip \
    -quality 88 "$pictures/styles.jpg"
  echo styles
fi
