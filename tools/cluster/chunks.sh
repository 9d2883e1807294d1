# Sourced by slurm.sh and parallel.sh: a `mvtp bench` or `mvtp sweep` in chunks.
#
# chunk I of N is `--shard I/N` of the command, with results of its own beside those of the whole:
# RESULTS.parts/I.csv. A chunk that is there already goes on where it stopped.

die() { echo "$(basename "$0"): $*" >&2; exit 2; }

# Reads the command behind "--" into command[], without its output, and output.
read_command() {
  [ $# -ge 2 ] || die "name the command behind --, e.g. -- mvtp sweep -c X.sumocfg -o results.csv"
  command=()
  output=
  while [ $# -gt 0 ]; do
    case $1 in
      -o | --output) [ $# -ge 2 ] || die "$1: name the file of the results"; output=$2; shift ;;
      --output=*) output=${1#*=} ;;
      --shard | --shard=*) die "--shard: the chunks are the shards; leave it out" ;;
      --resume) ;; # always
      *) command+=("$1") ;;
    esac
    shift
  done
  [ "${command[1]}" = bench ] || [ "${command[1]}" = sweep ] ||
    die "${command[1]}: can be done in chunks only for bench and sweep"
  command -v "${command[0]}" >/dev/null || die "${command[0]}: is no program; give its path"
  [ -n "$output" ] || die "-o FILE is missing: where the results of all chunks go"
  parts=$output.parts
  mkdir -p "$parts"
}

check_number() {
  case $2 in
    '' | *[!0-9]* | 0) die "$1 is \"$2\"; give a whole number from 1" ;;
  esac
}

# chunk_command I N: the words of chunk I, quoted for a shell; options of SUMO behind -- stay last.
chunk_command() {
  local part=$parts/$1.csv words=() placed= word
  local more=(--shard "$1/$2" -o "$part")
  [ ! -e "$part" ] || more+=(--resume)
  for word in "${command[@]}"; do
    if [ "$word" = -- ] && [ -z "$placed" ]; then
      words+=("${more[@]}")
      placed=1
    fi
    words+=("$word")
  done
  [ -n "$placed" ] || words+=("${more[@]}")
  printf '%q ' "${words[@]}"
}

# merge_chunks N: the results of all, if all are there.
merge_chunks() {
  local files=() missing=() i
  for ((i = 1; i <= $1; i++)); do
    if [ -s "$parts/$i.csv" ]; then files+=("$parts/$i.csv"); else missing+=("$i"); fi
  done
  if [ ${#missing[@]} -gt 0 ]; then
    echo "$(basename "$0"): chunks without results: ${missing[*]}; the same command again does" \
      "what is missing" >&2
    return 1
  fi
  "${command[0]}" "${command[1]}" merge "${files[@]}" -o "$output"
}
