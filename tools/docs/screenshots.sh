#!/usr/bin/env bash
# Takes the screenshots of the replay page in docs: tools/docs/screenshots.sh (needs chromium-headless-shell)
# MVTP=PROGRAM takes that program in place of the release build. A minute.
set -euo pipefail
cd "$(dirname "$0")/../.."
mvtp=$(realpath "${MVTP:-build/release/bin/mvtp}")
scenario=scenarios/crossroads/crossroads-400
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# shoot PAGE WIDTH,HEIGHT ADDRESS PICTURE [SCRIPT]: SCRIPT is run in the page before.
shoot() {
  sed "s#</body>#<script>addEventListener('load', () => setTimeout(() => { ${5:-} }, 500));</script></body>#" \
    "$1" >"$work/shown.html"
  chromium-headless-shell --no-sandbox --hide-scrollbars --force-device-scale-factor=1 \
    --window-size="$2" --virtual-time-budget=4000 --screenshot="docs/$4" "file://$work/shown.html#$3" 2>/dev/null
}

"$mvtp" compare -c "$scenario.sumocfg" --seeds 1 --controllers static,escot --output-dir "$work/both" --quiet \
  -- --end 300 >/dev/null || [ $? = 1 ]
"$mvtp" view "$work"/both/{static,escot}-1/view.html --label "static signal" --label escot -q -o "$work/both.html"
shoot "$work/both.html" 1280,720 t=150 replay-1280.png "document.getElementById('corridors').click()"
shoot "$work/both.html" 390,844 "t=150&movement=Ei%3EWo" replay-390.png

"$mvtp" coordinate -c "$scenario.static.sumocfg" --penetration 0.5 --seed 1 --no-fcd --quiet \
  --output-dir "$work/mixed" -- --end 60 || [ $? = 1 ]
shoot "$work/mixed/view.html" 1280,720 "t=51.7&sel=E-left.0&colour=penetration" replay-tube.png \
  "mvtp.setFollowing(true)"
