#!/bin/sh
# Runs every recipe and puts pictures before and after it side by side into docs/images/recipes/.
#   examples/recipes/pictures.sh path/to/normalshop path/to/models [folder for the results] [recipe...]
# Needs ImageMagick's convert. The models' folder is described in README.md.
set -eu
program=$1
models=$2
work=${3:-$(mktemp -d)}
[ $# -gt 3 ] && shift 3 && only=" $* " || only=
here=$(cd "$(dirname "$0")" && pwd)
pictures=$here/../../docs/images/recipes
mkdir -p "$pictures"

# Runs the program; its words are shown only where it fails.
run() {
  "$program" "$@" > "$work/run.log" 2>&1 || { cat "$work/run.log"; exit 1; }
}

# picture NAME MODEL "FLAGS FOR THE MODEL" "FLAGS FOR BOTH RENDERINGS" ["FLAGS FOR THE EDIT"
#   ["FLAGS FOR THE RENDERING BEFORE"]]
picture() {
  name=$1 model=$models/$2 out=$work/$1
  [ -z "$only" ] || case $only in *" $name "*) ;; *) return 0 ;; esac
  mkdir -p "$out"
  # Flags hold no spaces; they are split on purpose.
  run edit "$model" $3 ${5:-} --recipe "$here/$name.json" -o "$out"
  run render "$model" $3 $4 ${6:-} --resolution 1200x1200 -o "$work/$name-before.png"
  run render "$out/$(basename "$model")" $4 --resolution 1200x1200 -o "$work/$name-after.png"
  convert "$work/$name-before.png" "$work/$name-after.png" +append -filter Lanczos -resize 1200x600 \
    -strip -quality 88 "$pictures/$name.jpg"
  echo "$name: $(tr -d '\n' < "$out/report.json" |
    sed 's/.*"growth_degrees": *{ *"mean": *\([^,]*\),.*"p99": *\([^,]*\),.*}, *"texture_sets.*/seams grew by \1 degrees (mean), \2 (99th percentile)/')"
}

head=lee_perry_smith
head_model=$head/LeePerrySmith.glb
head_flags="--flip-v --normal-map $models/$head/Infinite-Level_02_Tangent_SmoothUV.jpg --size 4096"
skin="--albedo $models/$head/Map-COL.jpg"
picture scar $head_model "$head_flags" "$skin --width 3.2 --center -0.2,1.25,0"
picture words $head_model "$head_flags" "$skin --width 2.9 --center 0,2.4,0 --light 0,0.6,1"
picture wrinkles $head_model "$head_flags" "$skin --view=-0.35,0,1 --width 3.3 --center 0,1.75,0"
picture raised $head_model "$head_flags" "$skin --view=-1,0.3,1 --width 3 --center -0.3,1.9,0"
picture bumps $head_model "$head_flags" "$skin --view=0.35,0,1 --width 4.6 --center 0,1.5,0"
picture bricks $head_model "$head_flags" "$skin --view=0.35,0,1 --width 4.6 --center 0,1.5,0"
picture smooth $head_model "$head_flags" "$skin --width 2.6 --center 0,1.3,0 --light 0.5,0.5,1"
picture brows $head_model "$head_flags" "--width 3 --center 0,2,0" "$skin" "$skin"
picture exaggerate $head_model "${head_flags% --size 4096}" "$skin --view=-1,0.1,0.55 --width 5.4 --center 0,1.4,0 --light=0.2,0.8,0.6"
picture waterbottle khr_waterbottle/WaterBottle.gltf "" "--view=-0.3,0.3,1 --width 0.17 --center 0,0.048,0"
picture tea_set polyhaven_tea_set_01/tea_set_01_1k.gltf "--size 4096" \
  "--view=-0.1,1,0.6 --width 0.4 --center -0.23,0.02,-0.07 --light=-0.7,0.5,0.7"
picture spot spot/spot_quadrangulated.obj "--size 4096" \
  "--albedo $models/spot/spot_texture.png --view=-1,0.2,-0.8 --width 1.75 --center 0,0.1,0.12"
picture patches spot/spot_quadrangulated.obj "--size 4096" \
  "--albedo $models/spot/spot_texture.png --view=-1,0.2,-0.3 --light=-1,1,1" "--albedo $models/spot/spot_texture.png"

run demo -o "$work/demo"
models=$work
picture rope demo/head.gltf "" "--view=-0.8,0.1,0.6"
