"""The part of the CommonRoad format 2020a that mvtp writes, read off the schema that commonroad-io holds its files
against (XML_commonRoad_XSD.xsd).
"""

from schema_check import Type, faults_of

ID = {"id": "positiveInteger"}

TYPES = {
    "commonRoad": Type("location, scenarioTags, lanelet+, staticObstacle*, dynamicObstacle*, planningProblem+", {
        "commonRoadVersion": "Version", "benchmarkID": "string", "date": "date", "author": "string",
        "affiliation": "string", "source": "string", "timeStepSize": "decimal"}),
    "Version": "2020a",
    "Location": Type("geoNameId:integer, gpsLatitude:decimal, gpsLongitude:decimal"),
    "ScenarioTags": Type("simulated:string?"),
    # Shapes and places
    "Point": Type("x:decimal, y:decimal"),
    "Rectangle": Type("length:positiveDecimal, width:positiveDecimal, orientation:decimal?, center:Point?"),
    "Circle": Type("radius:positiveDecimal"),
    "Polygon": Type("point, point, point+"),
    "Shape": Type("(rectangle | circle | polygon)+"),
    "PointPosition": Type("point"),
    "AreaPosition": Type("rectangle+"),
    # Values: one, or from one to another
    "Exact": Type("exact:decimal"),
    "Interval": Type("intervalStart:decimal, intervalEnd:decimal"),
    "StepZero": Type("exact:zero"),
    "LaterStep": Type("exact:positiveInteger"),
    "Steps": Type("intervalStart:nonNegativeInteger, intervalEnd:positiveInteger"),
    # Roads
    "Lanelet": Type("leftBound:Bound, rightBound:Bound, laneletType+", ID),
    "LaneletType": "urban interstate country highway sidewalk crosswalk busLane bicycleLane exitRamp mainCarriageWay "
                   "accessRamp driveWay busStop unknown",
    "Bound": Type("point, point+"),
    # Obstacles
    "StaticObstacle": Type("type:StaticType, shape, initialState:ObstacleStart", ID),
    "StaticType": "unknown parkedVehicle constructionZone roadBoundary",
    "DynamicObstacle": Type("type:DynamicType, shape, initialState:ObstacleStart, trajectory", ID),
    "DynamicType": "unknown car truck bus motorcycle bicycle pedestrian priorityVehicle train",
    "ObstacleStart": Type("position:PointPosition & orientation:Exact & time:StepZero & velocity:Exact?"),
    "Trajectory": Type("state+"),
    "State": Type("position:PointPosition & orientation:Exact & time:LaterStep & velocity:Exact?"),
    # The planning problem
    "PlanningProblem": Type("initialState:ProblemStart, goalState+", ID),
    "ProblemStart": Type("position:PointPosition & orientation:Exact & time:StepZero & velocity:Exact & yawRate:Exact & "
                         "slipAngle:Exact"),
    "GoalState": Type("time:Steps & position:AreaPosition? & orientation:Interval?"),
}


def faults_in(root):
    faults = faults_of(root, TYPES, "commonRoad")
    ids = [child.get("id") for child in root if child.get("id")]
    return faults + [f"id {i}: is there twice" for i in sorted({i for i in ids if ids.count(i) > 1})]
