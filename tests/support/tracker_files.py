# SPDX-License-Identifier: GPL-3.0-or-later
"""Files as eye trackers write them, with the headers that their makers document, of one gaze: SAMPLES looks at pixels of a picture of 1920 x 1080
(or along the rays of the camera below), some of them lost. tests/datasets/trackers_test.py reads them, and the examples of docs/your_data.md."""

import gzip
import json

import numpy as np

SIZE = 1920, 1080
N = 40
LOST = range(10, 16)
MS = 1000 / 120 * np.arange(N)
PIXELS = np.stack([1160 + 40 * np.sin(np.arange(N) / 9), 540 + 30 * np.cos(np.arange(N) / 7)], axis=1).round(2)
CAMERA = {"width": 1920, "height": 1080, "fx": 1800, "fy": 1800, "world_to_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 9], [0, 0, 0, 1]]}
EYE = np.array([0, 0, -9.0])
DIRECTIONS = np.column_stack([(PIXELS - [960, 540]) / 1800, np.ones(N)])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)


def text(header, rows, separator=","):
    return "".join(separator.join(map(str, row)) + "\n" for row in [header.split(separator), *rows])


def tobii_pro_lab(people=("A",), stimuli=("cat",)):
    """With decimal commas, as under a German system, a gyroscope, and an event at the time of a sample."""
    names = ("Recording timestamp [ms]|Computer timestamp [ms]|Sensor|Participant name|Recording name|Event|Event value|Gaze point X [DACS px]|"
             "Gaze point Y [DACS px]|Gaze point X [MCS px]|Gaze point Y [MCS px]|Validity left|Validity right|Presented Stimulus name|Eye movement type")
    rows = []
    for person in people:
        for number, stimulus in enumerate(stimuli):
            for k, (x, y) in enumerate(PIXELS):
                time, whose = f"{MS[k] + 1000 * number:.3f}".replace(".", ","), [person, "Recording1"]
                end = [stimulus, "EyesNotFound" if k in LOST else "Fixation"]
                if k == 3:
                    rows.append([time, time, "", *whose, "KeyboardEvent", "Space", *[""] * 6, *end])
                gaze = [str(value).replace(".", ",") for value in (x, y, x - 10, y - 20)]
                rows.append([time, time, "Eye Tracker", *whose, "", "", *([""] * 4 if k in LOST else gaze), *["Invalid" if k in LOST else "Valid"] * 2, *end])
                rows.append([time, time, "Gyroscope", *whose, "", "", *[""] * 6, *end])
    return text(names.replace("|", "\t"), rows, "\t")


def tobii_glasses():
    eye = {"gazeorigin": [30.1, -9.5, -25.0], "gazedirection": [0.0, 0.0, 1.0], "pupildiameter": 3.5}
    rows = [{"type": "gaze", "timestamp": round(MS[k] / 1000, 6), "data": {} if k in LOST else
             {"gaze2d": [x / 1920, y / 1080], "gaze3d": [10.0, 5.0, 900.0], "eyeleft": eye, "eyeright": eye}} for k, (x, y) in enumerate(PIXELS)]
    rows.insert(5, {"type": "event", "timestamp": 0.03, "data": {"tag": "start"}})
    return gzip.compress("".join(json.dumps(row) + "\n" for row in rows).encode(), mtime=0)


def pupil_core():
    names = ("gaze_timestamp,world_index,confidence,norm_pos_x,norm_pos_y,base_data,gaze_point_3d_x,gaze_point_3d_y,gaze_point_3d_z,eye_center0_3d_x,"
             "eye_center0_3d_y,eye_center0_3d_z,gaze_normal0_x,gaze_normal0_y,gaze_normal0_z,eye_center1_3d_x,eye_center1_3d_y,eye_center1_3d_z,"
             "gaze_normal1_x,gaze_normal1_y,gaze_normal1_z")
    return text(names, [[5020.5 + MS[k] / 1000, k // 4, 0.1 if k in LOST else 0.97, x / 1920, 1 - y / 1080, f"{5020.5 + MS[k] / 1000:.4f}-0", *[""] * 15]
                        for k, (x, y) in enumerate(PIXELS)])


def pupil_neon():
    names = "section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn,fixation id,blink id,azimuth [deg],elevation [deg]"
    return text(names, [["0f1", "2b7", 1717000000000000000 + int(1e6 * MS[k]), x, y, 0 if k == LOST[0] else 1 if k % 3 else "", "", 1 if k in LOST[1:] else "", 0.1, 0.2]
                        for k, (x, y) in enumerate(PIXELS)])


def eyelink(trials=("cat",)):
    """Both eyes; the left one's gaze is 100 pixels to the left."""
    lines = ["** CONVERTED FROM a.edf", "** TYPE: EDF_FILE BINARY EVENT SAMPLE TAGGED", "MSG\t10000 GAZE_COORDS 0.00 0.00 1919.00 1079.00"]
    for number, trial in enumerate(trials):
        begin = 20000 + 5000 * number
        lines += [f"MSG\t{begin - 9} TRIALID {trial}", f"START\t{begin} \tLEFT\tRIGHT\tSAMPLES\tEVENTS", "PRESCALER\t1", "PUPIL\tAREA",
                  "EVENTS\tGAZE\tLEFT\tRIGHT\tRATE\t 120.00\tTRACKING\tCR\tFILTER\t2", "SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t 120.00\tTRACKING\tCR\tFILTER\t2"]
        for k, (x, y) in enumerate(PIXELS):
            gaze = ["   .", "   .", "    0.0"] * 2 if k in LOST else [f"{x - 100:.2f}", f"{y:.2f}", "1200.0", f"{x:.2f}", f"{y:.2f}", "1180.0"]
            lines.append("\t".join([f"{begin + MS[k]:.3f}", *gaze, "....."]))
        for eye, shift in (("L", 100), ("R", 0)):
            lines += [f"EFIX {eye}   {begin + a}\t{begin + b}\t{b - a}\t  {x - shift:.1f}\t  {y:.1f}\t   1200" for a, b, x, y in ((0, 80, 1170, 560), (130, 320, 1130, 530))]
        lines.append(f"END\t{begin + 334} \tSAMPLES\tEVENTS\tRES\t  36.00\t  36.00")
    return "\n".join(lines) + "\n"


def gazepoint():
    names = ("MEDIA_ID,MEDIA_NAME,CNT,TIME(2024/05/17 10:31:02.100),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,BPOGX,BPOGY,BPOGV,CX,CY,CS,"
             "USER,LPCX,LPCY,LPD,LPS,LPV,RPCX,RPCY,RPD,RPS,RPV,BKID,BKDUR,BKPMIN,")
    rows = [[0, "NewMedia0", k, f"{MS[k] / 1000:.5f}", 10000 * k, 1160 / 1920, 0.5, *((0, f"{MS[k] / 1000:.5f}", 1) if k < 10 else (0.13, f"{MS[k] / 1000 - .13:.5f}", 2)),
             int(k not in LOST), *(("-0.20000", "1.30000", 0) if k in LOST else (x / 1920, y / 1080, 1)), *[0] * 17, ""] for k, (x, y) in enumerate(PIXELS)]
    return text(names, rows)


def unity():
    """Varjo's example, of a shape whose x Unity has mirrored; the head is turned by a right angle around y (left-handed)."""
    names = ("Frame;CaptureTime;LogTime;HMDPosition;HMDRotation;GazeStatus;CombinedGazeForward;CombinedGazePosition;InterPupillaryDistanceInMM;"
             "LeftEyeStatus;LeftEyeForward;LeftEyePosition;RightEyeStatus;RightEyeForward;RightEyePosition;FocusDistance;FocusStability")

    def shown(*values):
        return "(" + ", ".join(f"{value:.9f}" for value in values) + ")"

    rows = []
    for k, (x, y, z) in enumerate(DIRECTIONS * [-1, 1, 1]):  # in the world; the head's x is -z of the world, its z is x
        gaze = ["INVALID", "", ""] if k in LOST else ["VALID", shown(-z, y, x), shown(0.0, 0.0, 0.03)]
        rows.append([k, 1716546700000000000 + int(1e6 * MS[k]), k, shown(EYE[0] - 0.03, *EYE[1:]), shown(0, np.sqrt(0.5), 0, np.sqrt(0.5)), *gaze, 63, *[""] * 6, 1, 1])
    return text(names, rows, ";")


def unity_world():
    """Rays in the world's frame, under names of one's own."""
    names = "Time,Valid," + ",".join(f"{name}.{axis}" for name in ("GazeOrigin", "GazeDirection") for axis in "xyz")
    return text(names, [[MS[k] / 1000, k not in LOST, *EYE, *(ray if k not in LOST else (0, 0, 0))] for k, ray in enumerate(DIRECTIONS * [-1, 1, 1])])


def eyenavgs():
    """The right eye looks elsewhere."""
    names = ("ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,QuaternionZ,QuaternionW,GazeQX,GazeQY,GazeQZ,GazeQW,"
             "GazePosX,GazePosY,GazePosZ,Timestamp")
    rows = []
    for k, ahead in enumerate(DIRECTIONS):
        turn = np.array([*np.cross([0, 0, -1], ahead), 1 - ahead[2]])  # the shortest way from -z; of half a turn nearly
        turn /= np.linalg.norm(turn)
        for eye in (0, 1):
            rows.append([eye, *[0.8] * 4, *[0] * 6, 1, *((0, 0, 0, 0) if k in LOST else turn if eye == 0 else (0, 0, 0, 1)), *EYE, repr(float(MS[k]))])
    return text(names, rows)
