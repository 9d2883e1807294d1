"""The part of ASAM OpenSCENARIO XML 1.2.0 that mvtp writes, read off its published schema (OpenSCENARIO.xsd)."""

from collections import Counter

from schema_check import Type, faults_of

NAMED = {"name": "string"}
REFERRING = {"entityRef": "string"}

TYPES = {
    "OpenSCENARIO": Type("FileHeader, CatalogLocations, RoadNetwork, Entities, Storyboard"),
    "FileHeader": Type("", {"author": "string", "date": "dateTime", "description": "string",
                            "revMajor": "nonNegativeInteger", "revMinor": "nonNegativeInteger"}),
    "CatalogLocations": Type(),
    "RoadNetwork": Type("LogicFile:File?"),
    "File": Type("", {"filepath": "string"}),
    # Bodies
    "Entities": Type("ScenarioObject*"),
    "ScenarioObject": Type("Vehicle", NAMED),
    "Vehicle": Type("BoundingBox & Performance & Axles & Properties", NAMED | {"vehicleCategory": "VehicleCategory"}),
    "VehicleCategory": "bicycle bus car motorbike semitrailer trailer train tram truck van",
    "BoundingBox": Type("Center & Dimensions"),
    "Center": Type("", {"x": "double", "y": "double", "z": "double"}),
    "Dimensions": Type("", {"height": "double", "length": "double", "width": "double"}),
    "Performance": Type("", {"maxAcceleration": "double", "maxDeceleration": "double", "maxSpeed": "double"}),
    "Axles": Type("FrontAxle:Axle, RearAxle:Axle"),
    "Axle": Type("", {"maxSteering": "double", "positionX": "double", "positionZ": "double", "trackWidth": "double",
                      "wheelDiameter": "double"}),
    "Properties": Type(),
    # The storyboard down to its events
    "Storyboard": Type("Init, Story*, StopTrigger:Trigger"),
    "Init": Type("Actions:InitActions"),
    "InitActions": Type("Private*"),
    "Private": Type("PrivateAction+", REFERRING),
    "Story": Type("Act+", NAMED),
    "Act": Type("ManeuverGroup+, StartTrigger:Trigger", NAMED),
    "ManeuverGroup": Type("Actors, Maneuver*", NAMED | {"maximumExecutionCount": "nonNegativeInteger"}),
    "Actors": Type("EntityRef*", {"selectTriggeringEntities": "boolean"}),
    "EntityRef": Type("", REFERRING),
    "Maneuver": Type("Event+", NAMED),
    "Event": Type("Action+, StartTrigger:Trigger?", NAMED | {"priority": "Priority"}),
    "Priority": "overwrite override parallel skip",
    # What is done
    "Action": Type("GlobalAction | PrivateAction", NAMED),
    "GlobalAction": Type("EntityAction"),
    "EntityAction": Type("AddEntityAction | DeleteEntityAction", REFERRING),
    "AddEntityAction": Type("Position"),
    "DeleteEntityAction": Type(),
    "PrivateAction": Type("TeleportAction | RoutingAction"),
    "TeleportAction": Type("Position"),
    "RoutingAction": Type("FollowTrajectoryAction"),
    "FollowTrajectoryAction": Type("TrajectoryRef & TimeReference & TrajectoryFollowingMode"),
    "TrajectoryRef": Type("Trajectory"),
    "Trajectory": Type("Shape", NAMED | {"closed": "boolean"}),
    "Shape": Type("Polyline"),
    "Polyline": Type("Vertex, Vertex+"),
    "Vertex": Type("Position", {"time?": "double"}),
    "Position": Type("WorldPosition"),
    "WorldPosition": Type("", {"x": "double", "y": "double", "h?": "double"}),
    "TimeReference": Type("Timing"),
    "Timing": Type("", {"domainAbsoluteRelative": "ReferenceContext", "offset": "double", "scale": "double"}),
    "ReferenceContext": "absolute relative",
    "TrajectoryFollowingMode": Type("", {"followingMode": "FollowingMode"}),
    "FollowingMode": "follow position",
    # When
    "Trigger": Type("ConditionGroup*"),
    "ConditionGroup": Type("Condition+"),
    "Condition": Type("ByValueCondition", NAMED | {"conditionEdge": "ConditionEdge", "delay": "double"}),
    "ConditionEdge": "falling none rising risingOrFalling",
    "ByValueCondition": Type("SimulationTimeCondition"),
    "SimulationTimeCondition": Type("", {"rule": "Rule", "value": "double"}),
    "Rule": "equalTo greaterThan lessThan greaterOrEqual lessOrEqual notEqualTo",
}


def faults_in(root):
    return faults_of(root, TYPES, "OpenSCENARIO") + faults_of_names(root)


def faults_of_names(root):
    """By the rules of ASAM's own checker that no schema can hold."""
    faults = []
    for parent in root.iter():
        names = Counter(child.get("name") for child in parent if child.get("name") is not None)
        faults += [f'{parent.tag}: has two called "{name}"' for name, count in names.items() if count > 1]
    known = {entity.get("name") for entity in root.iter("ScenarioObject")}
    for element in root.iterfind(".//*[@entityRef]"):
        if element.get("entityRef") not in known:
            faults.append(f'{element.tag}: no entity has the name "{element.get("entityRef")}"')
    for group in root.iter("ManeuverGroup"):
        if group.find(".//PrivateAction") is not None and group.find("Actors/EntityRef") is None:
            faults.append("ManeuverGroup: nobody is there for its private action")
    return faults
