//! Every field's name, unit and meaning, as `squitter decode --help` prints them. A test decodes frames of every kind and fails where a
//! field is not among them.

/// One line a field, or a group of one kind: the names before two spaces, separated by commas.
pub const FIELDS: &str = "\
Of every frame:
time                    seconds, as given with the frame
frame                   the frame in hexadecimal
df                      downlink format
kind                    what it turned out to be: velocity, comm_b_altitude, ...
crc                     exact | interrogator | address | broken | unjudged
crc_valid               true | false, of DF17, 18, 19
icao                    address, six hex digits; a candidate where crc says address
address_type            other: the address is none that ICAO gave out (anonymous, or a ground station's number)
latitude, longitude     degrees, of the tracked aircraft (needs times)

Replies, DF0, 4, 5, 11, 16, 20, 21, 24:
altitude                feet, pressure altitude (of TC 20-22 GNSS height)
altitude_metres         metres, where the field is metric
squawk                  four octal digits
capability              CA, 0-7; capability_text says it in words
capability_text         text
interrogator_code       CL and IC of a DF11, 1-79
interrogator_ii, interrogator_si  the same as II 1-15 or SI 0-63
flight_status           FS, 0-7; flight_status_text says it in words
flight_status_text      text
on_ground, alert, spi   true | false, where the frame tells
downlink_request        DR, 0-31
elm_segments            segments of a downlink ELM that DR announces, 1-16
utility_message         UM, 0-63
um_interrogator         IIS of UM, 0-15
um_reservation          IDS of UM: 0 nothing, 1 Comm-B, 2 Comm-C, 3 Comm-D
vertical_status         airborne | on-ground
cross_link_capability   CC, 0 | 1
sensitivity_level       SL, 0-7
reply_information       RI, 0-15
greatest_airspeed       knots, where RI tells it
mv, mb                  hexadecimal: MV of DF16, MB of DF20 and 21
ke                      DF24: 0 a downlink segment, 1 an answer to uplink segments
nd, md                  DF24: number of the segment; its ten bytes in hexadecimal
tas                     DF24: uplink segments received, 16 bits, the first highest
application_field       AF of DF19, 0-7
me                      hexadecimal, of TIS-B management

Squitters, DF17, 18, 19:
control_field           CF of DF18, 0-6
typecode                ME type code, 0-31
subtype                 of types that have subtypes
bds                     register that ME or MB copies: 0,5 ... 6,5
callsign                characters without spaces around
category                CA, 0-7, of the emitter category
emitter_category        set and number: A3
wake_vortex             the emitter category in words (in register 4,5: wake vortex, 0-3)
altitude_source         BARO | GNSS
surveillance_status     SS: 0 nothing, 1 permanent alert, 2 temporary alert, 3 SPI
nic_b                   0 | 1; before version 2: a single antenna
nuc_p                   NUCp, 0-9, by the type code
nic                     NIC, 0-11, of the tracked aircraft's position (needs times)
rc                      metres, containment radius of the same
utc_synchronised        true | false
cpr_format              0 even, 1 odd
cpr_lat, cpr_lon        0-131071; of a coarse position 0-4095
movement                0-127
track_status            0 | 1
service_volume          SVID of a coarse position, 0-15
groundspeed             knots
track                   degrees
heading                 degrees
airspeed                knots
airspeed_type           IAS | TAS
vertical_rate           feet a minute
vr_source               BARO | GNSS
geo_minus_baro          feet
intent_change, ifr_capable  true | false
nac_v                   NACv, 0-7
hfom_r, vfom_r          metres a second: what NACv stands for
nac_p                   NACp, 0-15
epu, vepu               metres: what NACp stands for
sil                     SIL, 0-3
sil_supplement          0 per hour, 1 per sample
pe_rcu                  probability that SIL stands for
nic_baro                0 | 1
emergency_state         0-7; emergency_state_text says it in words
emergency_state_text    none | general | medical | minimum fuel | no communications | unlawful interference | downed | reserved

Resolution advisories, of TC 28, register 3,0 and DF16:
issued_ra, corrective, downward_sense, increased_rate, sense_reversal, altitude_crossing, positive  true | false
corrects_upward, climb, corrects_downward, descend  true | false, where threats need different senses
no_below, no_above, no_left, no_right  true | false
ra_terminated, multiple_threat  true | false
tcas_ra                 true | false: an advisory is active
threat_type_indicator   0 unknown, 1 by address, 2 by place
threat_icao             six hex digits
threat_altitude         feet
threat_range            nautical miles
threat_bearing          degrees from the nose

Target state, TC 29:
selected_altitude       feet
selected_altitude_source  MCP/FCU | FMS | held | N/A
baro_pressure_setting   hectopascals
selected_heading        degrees
autopilot, vnav_mode, altitude_hold_mode, approach_mode, lnav_mode  true | false
tcas_operational        true | false
target_above_sea_level  true above sea level, false flight level (version 1, as the next five)
target_altitude_capability  0-3
vertical_mode, horizontal_mode  0 unknown, 1 acquiring, 2 capturing or holding
selected_angle_source   MCP/FCU | FMS | held
selected_track          degrees

Operational status, TC 31:
version                 of ADS-B, 0-7
capability_class, operational_mode  16 bits as sent
nic_supplement_a, nic_supplement_c  0 | 1
gva, sda, baq           0-3
gva_metres              metres: what GVA stands for
hrd                     headings are 0 true, 1 magnetic
trk_hdg                 surface positions hold 0 track, 1 heading
ident_switch, atc_services, cdti, arv_capability, ts_capability  true | false
tc_capability           0-3
position_offset_applied, es1090_in, uat_in, single_antenna, b2_low  true | false
length, width           metres, at most; by the code of the surface
antenna_lateral         metres right of the roll axis, negative left
antenna_behind_nose     metres

Comm-B registers, MB of DF20 and 21 (bds says which; a register that is not sure is not told):
bds_candidates          registers, where it is not sure
config, overlay_command_capability, acas_operational, transponder_level5  1,0: true | false
mode_s_specific_services, aircraft_identification_capability, squitter_capability  1,0: true | false
surveillance_identifier_code, common_usage_gicb_capability  1,0: true | false
acas_hybrid_surveillance, acas_resolution_advisory  1,0: true | false
mode_s_subnetwork_version  1,0: 0-127
uplink_elm_throughput, downlink_elm_throughput  1,0: codes 0-7, 0-15
acas_rtca_version       1,0: 0-3
dte_status              1,0: 16 bits, terminal 0 highest
supported_bds           1,7: registers
selected_altitude_mcp, selected_altitude_fms  4,0: feet
target_altitude_source  4,0: unknown | aircraft_altitude | mcp_fcu | fms
figure_of_merit         4,4: 0-15
wind_speed              4,4: knots
wind_direction          4,4: degrees
static_air_temperature  4,4, 4,5: degrees Celsius
static_pressure         4,4, 4,5: hectopascals
humidity                4,4: per cent
turbulence              4,4, 4,5: 0 nil to 3 severe
wind_shear, microburst, icing  4,5: 0-3
radio_height            4,5: feet
roll                    5,0: degrees, right wing down positive
true_track              5,0: degrees
track_rate              5,0: degrees a second, to the right positive
true_airspeed           5,0: knots
magnetic_heading        6,0: degrees
indicated_airspeed      6,0: knots
mach                    6,0
baro_vertical_rate, inertial_vertical_rate  6,0: feet a minute";
