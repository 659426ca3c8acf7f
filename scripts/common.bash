# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by the scripts of this directory: where the project is, how to speak, what MPI needs.

tombolo_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)

# The python of the distribution has the packages that scripts/setup installs; another python that
# comes first on PATH usually has not.
tombolo_python=/usr/bin/python3

say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }

die()
{
  say "$*"
  exit 1
}

# usage_of SCRIPT: prints the comment at the head of the script, with the names that an installed
# Tombolo gives to its commands.
usage_of()
{
  awk -v is_installed="$([[ -x $tombolo_root/scripts/setup ]] || echo 1)" '
    NR > 1 && /^#/ {
      sub(/^# ?/, "")
      if (is_installed && gsub(/scripts\//, "tombolo-")) {
        gsub(/tombolo-plot_/, "tombolo-plot-")
        gsub(/tombolo-reflection_/, "tombolo-reflection-")
      }
      print
      next
    }
    NR > 1 { exit }' "$1"
}

# nproc obeys OMP_NUM_THREADS, which is one here.
tombolo_cores=$(env -u OMP_NUM_THREADS nproc)

# prepare_python MODULE...: installs what is missing, in a clone of the project. An installed Tombolo
# has no scripts/setup, and says what is missing.
prepare_python()
{
  local missing
  [[ ! -x $tombolo_root/scripts/setup || $# -eq 0 ]] || "$tombolo_root/scripts/setup"
  [[ -x $tombolo_python ]] || tombolo_python=python3
  command -v "$tombolo_python" >/dev/null || die "please install python3"
  missing=$("$tombolo_python" -c 'import sys
from importlib.util import find_spec
print(*(name for name in sys.argv[1:] if find_spec(name) is None))' "$@")
  [[ -z $missing ]] ||
    die "$tombolo_python has no $missing; on Debian: apt-get install python3-numpy python3-scipy python3-matplotlib python3-vtk9 python3-h5py"
}

# plugins_of ARGUMENT...: the targets of plug-in libraries of the project that files among the arguments
# name.
plugins_of()
{
  local argument name
  for argument in "$@"; do
    [[ ! -f $argument ]] || grep -ohE '\blib[a-z_]+\.so\b' "$argument" || true
  done | sort -u | while read -r name; do
    name=${name#lib}
    [[ ! -d $tombolo_root/tests/plugin_${name%.so} ]] || echo "${name%.so}"
  done
}

# One job per core, but not more than one per two gigabytes of memory: a translation unit of
# deal.II takes more than one.
parallel_jobs()
{
  local kilobytes jobs
  kilobytes=$(awk '/^MemTotal:/ { print $2 }' /proc/meminfo)
  jobs=$((kilobytes / 2000000))
  ((jobs >= 1)) || jobs=1
  ((jobs <= tombolo_cores)) || jobs=$tombolo_cores
  echo "$jobs"
}

# Open MPI refuses root (containers, CI) and more ranks than cores without these; the last is for
# version 5.
export OMPI_ALLOW_RUN_AS_ROOT=1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1
export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
# Ranks, not threads, share the work.
export OMP_NUM_THREADS=1
export DEAL_II_NUM_THREADS=1
