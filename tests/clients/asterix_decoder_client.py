"""A second opinion on ASTERIX: what asterix-decoder (PyPI) understands of a byte stream.

Reads bytes from a file or standard input; prints one JSON line a record, with the keys of `asterix_client.py` for what both name. It knows only
CAT021 edition 2.1 and CAT023 edition 1.2 in its newer definitions, so it is no judge of editions. Its module has libasterix's name: run it in an
environment of its own.
"""

import asterix
import asterix_stream

# Item, its name of a value: the specification's key.
KEYS = {
    "I010": {"SAC": "010/SAC", "SIC": "010/SIC"},
    "I040": {"ATP": "040/ATP", "ARC": "040/ARC", "RC": "040/RC", "RAB": "040/RAB", "GBS": "040/GBS"},
    "I131": {"Lat": "131/LAT", "Lon": "131/LON"},
    "I150": {"IM": "150/IM"},
    "I151": {"TAS": "151/TAS"},
    "I080": {"TAddr": "080"},
    "I073": {"time_reception_position": "073"},
    "I075": {"time_reception_velocity": "075"},
    "I140": {"geometric_height": "140"},
    "I090": {
        "NUCr_or_NACv": "090/NUCRNACV",
        "NUCp_or_NIC": "090/NUCPNIC",
        "NICbaro": "090/NICBARO",
        "SIL": "090/SIL",
        "NACp": "090/NACP",
        "SDA": "090/SDA",
        "GVA": "090/GVA",
    },
    "I210": {"VNS": "210/VNS", "VN": "210/VN", "LTT": "210/LTT"},
    "I070": {"Mode3A": "070/MODE3A"},
    "I145": {"FL": "145"},
    "I200": {"ICF": "200/ICF", "LNAV": "200/LNAV", "PS": "200/PS", "SS": "200/SS"},
    "I155": {"RE": "155/RE", "BVR": "155/BVR"},
    "I157": {"RE": "157/RE", "GVR": "157/GVR"},
    "I160": {"RE": "160/RE", "GS": "160/GS", "TA": "160/TA"},
    "I077": {"time_report_transmission": "077"},
    "I170": {"TId": "170"},
    "I020": {"ECAT": "020"},
    "I132": {"MAM": "132"},
    "I000": {"report_type": "000"},
    "I100": {"NOGO": "100/NOGO", "TSV": "100/TSV"},
}


def records(data):
    for parsed in asterix.parse(data, verbose=False):
        told = {"category": parsed["category"]}
        for item, values in parsed.items():
            if not isinstance(values, dict):
                continue
            for name, value in values.items():
                key = KEYS.get(item, {}).get(name)
                if parsed["category"] == 23 and item == "I070":
                    key = "070" if name == "ToD" else None
                if key is not None:
                    value = value["val"]
                    told[key] = int(value, 16) if key == "080" else value
        yield told


if __name__ == "__main__":
    asterix_stream.tell(records)
