#!/bin/sh
# Error against run time on this machine, and the tables of README.md, docs/error-and-speed.md and
# docs/notes/error-against-time.md made of it:
#
#   bench/pareto.sh build/release/bin/pbf-bench bench/results/MACHINE [SCENE ...]
#
# One thread, processor time: other work on the machine then only adds noise. Goes on where it was.
# Pages go to out/.
set -eu
program=$1 results=$2
shift 2
[ $# -gt 0 ] || set -- dam-break-3d still-tank drop-into-pool
cd "$(dirname "$0")/.."
for scene; do
  # Numbers of particles whose lattice fits between the walls.
  case $scene in
    dam-break-3d) particles=3840 duration=1.5 ;;
    still-tank) particles=2560 duration=2 ;;
    drop-into-pool) particles=1720 duration=1.5 ;;
    *) echo "$0: the scene is $scene; known: dam-break-3d, still-tank, drop-into-pool" >&2; exit 2 ;;
  esac
  "$program" pareto --scene "$scene" --particles $particles --duration $duration --frames 6 \
    --repetitions 3 --cpu-time --json "$results/pareto-$scene.json" --html "out/pareto-$scene.html"
done
bench/tools/pareto_table.py "$results"/pareto-*.json
