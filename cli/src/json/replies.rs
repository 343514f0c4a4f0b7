//! Replies: DF0, 4, 5, 11, 16, 20, 21, and what stands apart: DF19 of the military, DF24, TIS-B management.

use super::{Fields, advisory};
use mode_s::{AcasReply, Body, Capability, CommD, FlightStatus, MeBits, Message, ReplyControl};

pub(super) fn put(message: &Message, fields: &mut Fields) {
    match &message.body {
        Body::AirAir {
            on_ground,
            acas,
            altitude,
            metres,
            mv,
        } => {
            let status = if *on_ground { "on-ground" } else { "airborne" };
            fields.put("vertical_status", status);
            fields.put("on_ground", *on_ground);
            put_acas(acas, mv.is_none(), fields);
            fields.altitude(*altitude);
            fields.may_put("altitude_metres", *metres);
            fields.may_put("mv", mv.map(hexadecimal));
            if let Some(coordination) = message.coordination() {
                advisory::put(&coordination, fields);
            }
        }
        Body::AltitudeReply {
            flight_status,
            control,
            altitude,
            metres,
            ..
        } => {
            put_status(*flight_status, *control, fields);
            fields.altitude(*altitude);
            fields.may_put("altitude_metres", *metres);
        }
        Body::IdentityReply {
            flight_status,
            control,
            squawk,
            ..
        } => {
            put_status(*flight_status, *control, fields);
            fields.squawk(*squawk);
        }
        Body::AllCallReply { capability } => put_capability(*capability, fields),
        Body::Management { content } => {
            fields.put("control_field", 4);
            fields.put("me", hexadecimal(*content));
        }
        Body::Military { application } => fields.put("application_field", *application),
        Body::CommD(segment) => put_comm_d(segment, fields),
        Body::ExtendedSquitter { .. } | Body::CoarsePosition(_) | Body::NotDecoded => {}
    }
}

pub(super) fn hexadecimal(bits: MeBits) -> String {
    bits.bytes().map(|byte| format!("{byte:02X}")).concat()
}

fn put_acas(acas: &AcasReply, has_cross_link: bool, fields: &mut Fields) {
    if has_cross_link {
        fields.put("cross_link_capability", u8::from(acas.cross_link));
    }
    fields.put("sensitivity_level", acas.sensitivity_level);
    fields.put("reply_information", acas.reply_information);
    fields.may_put("greatest_airspeed", acas.greatest_airspeed_kt());
}

fn put_status(status: FlightStatus, control: ReplyControl, fields: &mut Fields) {
    let text = match status.0 {
        0 => "airborne",
        1 => "on ground",
        2 => "alert, airborne",
        3 => "alert, on ground",
        4 => "alert, SPI",
        5 => "SPI",
        _ => "reserved",
    };
    fields.put("flight_status", status.0);
    fields.put("flight_status_text", text);
    fields.may_put("on_ground", status.on_ground());
    fields.may_put("alert", status.alert());
    fields.may_put("spi", status.ident());
    fields.put("downlink_request", control.downlink_request);
    fields.put("utility_message", control.utility_message);
    fields.put("um_interrogator", control.interrogator());
    fields.put("um_reservation", control.reservation());
    fields.may_put("elm_segments", control.elm_segments());
}

pub(super) fn put_capability(capability: Capability, fields: &mut Fields) {
    let text = match capability.0 {
        0 => "level 1",
        1..=3 => "reserved",
        4 => "level 2 or more, on ground",
        5 => "level 2 or more, airborne",
        6 => "level 2 or more",
        _ => "downlink request, alert or SPI",
    };
    fields.put("capability", capability.0);
    fields.put("capability_text", text);
    fields.may_put("on_ground", capability.on_ground());
}

fn put_comm_d(segment: &CommD, fields: &mut Fields) {
    fields.put("ke", u8::from(segment.is_acknowledgement));
    fields.put("nd", segment.segment);
    let content = segment.content.map(|byte| format!("{byte:02X}"));
    fields.put("md", content.concat());
    fields.may_put("tas", segment.received_segments());
}
