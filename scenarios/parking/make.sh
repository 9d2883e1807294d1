#!/usr/bin/env bash
# Makes the parking lots: networks, lots, demand and configurations.
#
#   parking.net.xml, angled.net.xml     an entry lane and an exit lane, joined at a gate (netconvert)
#   parking.add.xml, angled.add.xml     the lots themselves: ground, islands, slots
#   parking-Q.rou.xml, angled-Q.rou.xml Q veh/h come, and as many go; 24 (8) are there at the start
#   parking-walkers.rou.xml             people on the footpath across the lot
#   *.sumocfg                           parking.sumocfg is parking-120.sumocfg
#
# Sizes are in metres, angles in degrees. A slot is a <space> of a parkingArea: SUMO puts the front
# bumper of a parked car at (x, y), heading angle - 90 degrees counter-clockwise from east; the space
# is the `length` behind it. SUMO fills the spaces in the order of the file, so that this order, and
# with it who stands where at the start, is mixed.
set -euo pipefail
cd "$(dirname "$0")"

network() {
  netconvert --node-files "$1.nod.xml" --edge-files "$1.edg.xml" --connection-files "$1.con.xml" \
    --no-turnarounds --offset.disable-normalization --output-file "$1.net.xml"
}

# The slots of a lot, one per line: x y of the middle, heading into the slot, length, width.
#
# Six columns along three aisles of 6 m; each is parted by the footpath at y = 19 to 21. The last one
# is for vans, the first one is a little longer than the others for large cars.
perpendicular_slots() {
  awk 'function column(x0, length_, heading, width, n,   i) {
         for (i = 0; i < n; ++i)
           printf "%.3f %.3f %d %.2f %.2f\n", x0 + length_ / 2, 6.5 + (i + 0.5) * width, heading, length_, width
         for (i = 0; i < n; ++i)
           printf "%.3f %.3f %d %.2f %.2f\n", x0 + length_ / 2, 21 + (i + 0.5) * width, heading, length_, width
       }
       BEGIN {
         column(0.3, 5.5, 180, 2.5, 5)
         column(11.8, 5, 0, 2.5, 5); column(17.2, 5, 180, 2.5, 5)
         column(28.2, 5, 0, 2.5, 5); column(33.6, 5, 180, 2.5, 5)
         column(44.6, 6, 0, 2.8, 4)
       }'
}

# Two rows of slots at 60 degrees to an aisle of 4.6 m along y = 0, for cars that come from the west.
angled_slots() {
  awk 'BEGIN {
         rad = atan2(0, -1) / 180; length_ = 5.4; width = 2.6
         pitch = width / sin(60 * rad)                                   # along the aisle
         depth = (length_ * sin(60 * rad) + width * cos(60 * rad)) / 2   # to the middle
         for (side = 1; side >= -1; side -= 2)
           for (i = 0; i < 12; ++i)
             printf "%.3f %.3f %d %.2f %.2f\n", 5 + i * pitch, side * (2.3 + depth), side * 60, length_, width
       }'
}

# Slots on stdin, in SUMO's terms: x y angle width length. Every fourth car stands the other way round.
spaces() {
  awk '{ line[NR] = $0 }
       END {
         rad = atan2(0, -1) / 180
         for (i = 1; i <= NR; ++i) {
           split(line[i * 23 % (NR + 1)], slot, " ")  # each once: 23 and NR + 1 have no divisor
           heading = slot[3] + (i % 4 == 0 ? 180 : 0)
           printf "        <space x=\"%.3f\" y=\"%.3f\" angle=\"%d\" width=\"%s\" length=\"%s\"/>\n", \
             slot[1] + slot[4] / 2 * cos(heading * rad), slot[2] + slot[4] / 2 * sin(heading * rad), \
             (heading + 90) % 360, slot[5], slot[4]
         }
       }'
}

# The spaces on stdin as a parkingArea: SUMO's drivers stop for it near the end of the entry.
parking_area() {
  echo '    <parkingArea id="lot" lane="entry_0" startPos="185" endPos="195">'
  cat
  echo '    </parkingArea>'
}

# polygon ID TYPE COLOUR LAYER SHAPE
polygon() {
  echo "    <poly id=\"$1\" type=\"$2\" color=\"$3\" fill=\"1\" layer=\"$4\" shape=\"$5\"/>"
}

additional() {
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo '<additional>'
  cat
  echo '</additional>'
}

perpendicular_lot() {
  # Entry and exit have arms of their own, as wide as one car needs.
  polygon lot parking.ground 200,200,200 -2 \
    "-28,1.25 0,1.25 0,0 51,0 51,40 0,40 0,38.75 -28,38.75 -28,34.75 0,34.75 0,5.25 -28,5.25"
  local name x0 x1
  while read -r name x0 x1; do
    polygon "island-$name-south" parking.obstacle 90,140,90 -1 "$x0,6 $x1,6 $x1,6.4 $x0,6.4"
    polygon "island-$name-north" parking.obstacle 90,140,90 -1 "$x0,33.6 $x1,33.6 $x1,34 $x0,34"
  done <<< $'west 13 21\neast 29.4 37.4'
  perpendicular_slots | spaces | parking_area
}

angled_lot() {
  polygon lot parking.ground 200,200,200 -2 \
    "-28,-2 -5,-2 -2,-8.6 40,-8.6 47,-2 70,-2 70,2 47,2 40,8.6 -2,8.6 -5,2 -28,2"
  angled_slots | spaces | parking_area
}

# parked COUNT < spaces: vehicles that are there at the start, each fit for the space that SUMO gives
# it, and leave one after the other during the hour.
parked() {
  awk -v count="$1" -F'"' '
    /<space/ && NR <= count {
      type = $10 > 5.5 && !vans++ ? "van" : $10 > 5.3 && NR % 2 == 0 ? "large" : NR % 3 == 0 ? "estate" : NR % 3 == 1 ? "medium" : "compact"
      printf "    <vehicle id=\"parked.%d\" type=\"%s\" depart=\"0\" departPos=\"stop\">", NR - 1, type
      printf "<route edges=\"entry exit\"/><stop parkingArea=\"lot\" duration=\"%d\"/></vehicle>\n", \
        3600 * ((NR * 7) % count + 0.5) / count
    }'
}

# arrivals VEHICLES_PER_HOUR MEAN_MINUTES TYPE: 20 Poisson flows for an hour that differ in how long
# their vehicles stay, a quarter of the mean and an exponentially distributed rest.
arrivals() {
  awk -v rate="$1" -v mean="$2" -v type="$3" 'BEGIN {
    n = 20
    for (k = 0; k < n; ++k) {
      stay = 60 * mean * (0.25 - 0.75 * log(1 - (k + 0.5) / n))
      printf "    <flow id=\"in%02d\" type=\"%s\" begin=\"0\" end=\"3600\" period=\"exp(%.7f)\" departSpeed=\"max\">", \
        k, type, rate / n / 3600
      printf "<route edges=\"entry exit\"/><stop parkingArea=\"lot\" duration=\"%d\"/></flow>\n", stay
    }
  }'
}

# demand PARKED VEHICLES_PER_HOUR MEAN_MINUTES TYPE < additional file: see parked() and arrivals()
demand() {
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo "<!-- $2 veh/h that stay $3 min on average; $1 are there at the start. -->"
  echo '<routes>'
  grep '<space' | parked "$1"
  arrivals "$2" "$3" "$4"
  echo '</routes>'
}

walkers() {
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo '<!-- 60 people per hour in each direction. -->'
  echo '<routes>'
  echo '    <personFlow id="eastbound" begin="0" end="3600" period="exp(0.0166667)" departPos="0">'
  echo '        <walk edges="footpath"/></personFlow>'
  echo '    <personFlow id="westbound" begin="0" end="3600" period="exp(0.0166667)" departPos="91">'
  echo '        <walk edges="footpath" arrivalPos="0"/></personFlow>'
  echo '</routes>'
}

# configuration LOT ROUTE_FILES
configuration() {
  cat <<SUMOCFG
<?xml version="1.0" encoding="UTF-8"?>
<configuration>
    <input>
        <net-file value="$1.net.xml"/>
        <route-files value="$2"/>
        <additional-files value="types.add.xml,$1.add.xml"/>
    </input>
    <time>
        <step-length value="0.1"/>
    </time>
    <processing>
        <time-to-teleport value="-1"/>
    </processing>
</configuration>
SUMOCFG
}

network parking
perpendicular_lot | additional > parking.add.xml
demand 24 120 8 mix < parking.add.xml > parking-120.rou.xml
demand 24 240 5 mix < parking.add.xml > parking-240.rou.xml
walkers > parking-walkers.rou.xml
configuration parking parking-120.rou.xml > parking-120.sumocfg
configuration parking parking-240.rou.xml > parking-240.sumocfg
configuration parking parking-120.rou.xml,parking-walkers.rou.xml > parking-walkers.sumocfg
cp parking-120.sumocfg parking.sumocfg

network angled
angled_lot | additional > angled.add.xml
demand 8 60 8 cars < angled.add.xml > angled-60.rou.xml
configuration angled angled-60.rou.xml > angled.sumocfg
