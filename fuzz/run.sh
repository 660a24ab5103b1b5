#!/bin/bash
# Fuzzes with AddressSanitizer, guided by coverage, one target after the other.
#
#   cargo install cargo-fuzz
#   fuzz/run.sh                            # every target, ten million executions each (decomposition: ten thousand)
#   fuzz/run.sh -n 100000 urdf states      # these targets, so many executions each
#   fuzz/run.sh -m urdf                    # makes the kept corpus of these anew: a sample that reaches what all reached
#
# Goes on from target/fuzz/corpus/<target>, begins with the kept corpus, logs to target/fuzz/<target>.log; findings go
# to target/fuzz/found/<target>/. Stops with an error at the first finding. On a stable toolchain. A kept corpus is an
# archive; fuzz/corpus.py unpacks and packs it.
set -euo pipefail
cd "$(dirname "$0")/.."
executions=10000000 merge=false most=120
while getopts n:m option; do
  case $option in
    n) executions=$OPTARG ;;
    m) merge=true ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
if [ $# -eq 0 ]; then
  set -- stl obj ply collada gltf urdf srdf settings model states calls calls3 viewer scene xacro heights surface image tables fmu decomposition
fi
work=$PWD/target/fuzz
host=$(rustc -vV | sed -n 's/^host: //p')
# What a call to malloc costs counts: no stack traces of the ones before, no quarantine, no filling.
export ASAN_OPTIONS=detect_odr_violation=0:malloc_context_size=0:detect_stack_use_after_return=0
ASAN_OPTIONS+=:quarantine_size_mb=0:thread_local_quarantine_size_kb=0:max_malloc_fill_size=0
for target in "$@"; do
  words='' folder=fuzz count=$executions
  case $target in
    # Length: what the format needs to show all it has.
    stl) folder=fuzz/readers length=512 ;;
    obj) folder=fuzz/readers length=200 ;;
    ply) folder=fuzz/readers length=400 words=fuzz/readers/ply.dict ;;
    gltf) folder=fuzz/readers length=1500 words=fuzz/readers/gltf.dict ;;
    collada) folder=fuzz/readers length=900 words=fuzz/readers/collada.dict ;;
    urdf) folder=fuzz/readers length=500 words=fuzz/readers/urdf.dict ;;
    srdf) folder=fuzz/readers length=500 words=fuzz/readers/srdf.dict ;;
    decomposition) folder=fuzz/readers length=73 count=$((executions < 10000 ? executions : 10000)) ;;
    scene) folder=fuzz/readers length=900 words=fuzz/readers/scene.dict ;;
    xacro) folder=fuzz/readers length=500 words=fuzz/readers/xacro.dict ;;
    heights) folder=fuzz/readers length=400 words=fuzz/readers/heights.dict ;;
    surface) folder=fuzz/readers length=500 ;;
    image) folder=fuzz/readers length=600 ;;
    tables) folder=fuzz/readers length=300 words=fuzz/readers/tables.dict ;;
    fmu) folder=fuzz/readers length=1200 words=fuzz/readers/fmu.dict ;;
    settings) length=200 words=fuzz/settings.dict ;;
    model) length=64 ;;
    states) length=96 ;;
    calls|calls3) length=400 ;;
    viewer) length=600 words=fuzz/viewer.dict ;;
    *) echo "there is no target '$target'" >&2 && exit 2 ;;
  esac
  archive=$folder/corpus/$target.zip
  kept=$work/kept/$target corpus=$work/corpus/$target found=$work/found/$target
  rm -rf "$kept" && mkdir -p "$corpus" "$found"
  python3 fuzz/corpus.py unpack "$archive" "$kept"
  # Comparisons are not traced: that takes a third of the time, and the dictionaries hold the words.
  RUSTC_BOOTSTRAP=1 cargo fuzz build --fuzz-dir "$folder" --target-dir "$work" --no-trace-compares "$target"
  binary=$work/$host/release/$target
  if $merge; then
    rm -rf "$work/smallest" && mkdir "$work/smallest"
    "$binary" -merge=1 -max_len="$length" "$work/smallest" "$kept" "$corpus" > "$work/$target.merge.log" 2>&1
    # By length: of these a sample is kept, the same each time, beside what was found.
    find "$kept" -type f ! -name 'hang_*' -delete
    find "$work/smallest" -type f -printf '%s %f\n' | sort -n | awk -v most=$most \
      '{ name[NR] = $2 } END { step = NR > most ? NR / most : 1; for (i = 1; i <= NR; i += step) print name[int(i)] }' |
      while read -r name; do cp "$work/smallest/$name" "$kept/${name:0:12}"; done
    python3 fuzz/corpus.py pack "$kept" "$archive"
    continue
  fi
  echo "$target: $count executions"
  "$binary" "$corpus" "$kept" -artifact_prefix="$found/" -runs="$count" -max_len="$length" ${words:+-dict="$words"} \
    -entropic=0 -reduce_inputs=0 -detect_leaks=0 -timeout=10 -rss_limit_mb=1024 -print_final_stats=1 \
    > "$work/$target.log" 2>&1 || { tail -n 30 "$work/$target.log" >&2; exit 1; }
  grep -E 'DONE|number_of_executed_units|peak_rss_mb' "$work/$target.log"
  # What reached something new runs once more, with the quarantine, watched for memory that is not given back.
  ASAN_OPTIONS=detect_odr_violation=0 "$binary" "$corpus" -runs=0 -detect_leaks=1 -rss_limit_mb=4096 \
    > "$work/$target.leaks.log" 2>&1 || { tail -n 30 "$work/$target.leaks.log" >&2; exit 1; }
done
