//! Values of the command line.

use std::net::IpAddr;
use std::ops::RangeInclusive;

use crate::data::Role;
use crate::episode::Split;
use crate::measure::failure::Order;
use crate::model::config::Preset;

pub(super) fn parse_size(text: &str) -> Result<(u16, u16), String> {
    let parse = || {
        let (columns, rows) = text.split_once('x')?;
        Some((columns.parse().ok()?, rows.parse().ok()?))
    };
    parse()
        .filter(|&(columns, rows)| (1..=1000).contains(&columns) && (1..=1000).contains(&rows))
        .ok_or_else(|| format!("{text:?} is not COLUMNSxROWS, for example 120x40"))
}

pub(super) fn parse_host(text: &str) -> Result<IpAddr, String> {
    let text = if text == "localhost" {
        "127.0.0.1"
    } else {
        text
    };
    text.parse().map_err(|_| {
        format!("{text:?} is no address of this machine, for example 127.0.0.1 or 0.0.0.0")
    })
}

pub(super) fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = text
        .parse::<f64>()
        .ok()
        .filter(|minutes| minutes.is_finite() && *minutes > 0.0);
    minutes.ok_or_else(|| format!("{text:?} is not a positive number of minutes"))
}

pub(super) fn parse_preset(name: &str) -> Result<Preset, String> {
    Preset::ALL
        .into_iter()
        .find(|preset| preset.name() == name)
        .ok_or_else(|| format!("there are {}", Preset::ALL.map(Preset::name).join(", ")))
}

/// Up to a month; 0 is after every update.
pub(super) fn parse_interval(text: &str) -> Result<f64, String> {
    let minutes = text.parse::<f64>().ok();
    minutes
        .filter(|minutes| (0.0..=43_200.0).contains(minutes))
        .ok_or_else(|| format!("{text:?} is not a number of minutes from 0 to 43200"))
}

pub(super) fn parse_bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, u64); 3] = [("KiB", 1 << 10), ("MiB", 1 << 20), ("GiB", 1 << 30)];
    let unit = UNITS
        .into_iter()
        .find_map(|(unit, bytes)| Some((text.strip_suffix(unit)?, bytes)));
    let (number, unit) = unit.unwrap_or((text, 1));
    let bytes = number.trim().parse::<u64>().ok();
    bytes
        .and_then(|number| number.checked_mul(unit))
        .ok_or_else(|| format!("{text:?} is not a whole number of bytes, KiB, MiB or GiB: 2GiB"))
}

pub(super) fn parse_split(text: &str) -> Result<Split, String> {
    Split::from_name(text).ok_or_else(|| format!("{text:?} is not train, val or test"))
}

/// A number of images, of an hour at 30 Hz at most.
pub(super) fn parse_images(text: &str) -> Result<usize, String> {
    const MOST: usize = 108_000;
    let images = text
        .parse()
        .ok()
        .filter(|images| (1..=MOST).contains(images));
    images.ok_or_else(|| format!("{text:?} is not a number of images, 1 to {MOST}"))
}

/// First and last step from 1 on, as they are counted on screen.
pub(super) fn parse_steps(text: &str) -> Result<RangeInclusive<usize>, String> {
    let parse = || {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        Some(first.trim().parse().ok()?..=last.trim().parse().ok()?)
    };
    parse()
        .filter(|steps: &RangeInclusive<usize>| *steps.start() > 0 && !steps.is_empty())
        .ok_or_else(|| format!("{text:?} is not FIRST-LAST, counted from 1, for example 4-9"))
}

pub(super) fn parse_order(name: &str) -> Result<Order, String> {
    Order::from_name(name).ok_or_else(|| {
        let names = Order::ALL.map(Order::name).join(", ");
        format!("there are {names}")
    })
}

pub(super) fn parse_topic(text: &str) -> Result<(Role, String), String> {
    let (role, topic) = text
        .split_once('=')
        .filter(|(_, topic)| !topic.is_empty())
        .ok_or_else(|| format!("{text:?} is not ROLE=TOPIC, for example vision=/camera/image"))?;
    let role = Role::from_name(role).ok_or_else(|| {
        let names = Role::ALL.map(Role::name).join(", ");
        format!("there is no role {role:?}, only {names}")
    })?;
    Ok((role, topic.to_owned()))
}

/// `2/4`: the second of four.
pub(super) fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let shard = text
        .split_once('/')
        .and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match shard {
        Some((i, n)) if (1..=n).contains(&i) => Ok((i, n)),
        _ => Err(format!("{text:?} is not like 2/4, the second of four")),
    }
}
