//! Compares a definition that came with a file with the layout that is decoded here: a type that was changed under
//! its name would decode to nonsense, so its topic is left out instead.

use re_ros_msg::MessageSchema;
use re_ros_msg::message_spec::{ArraySize, BuiltInType, ComplexType, MessageSpecification, Type};

use super::message_type::MessageType;

/// Deeper nesting than any ROS message has; a type that contains itself is deeper still.
const DEPTH_LIMIT: usize = 16;
/// More text, or more fields, than any of the format's types can have.
const TEXT_LIMIT: usize = 1 << 20;
const FIELD_LIMIT: usize = 1000;

/// Whether messages of `text` (in `ros2msg`) have the layout of `ty`.
///
/// # Errors
/// A phrase that says what differs.
pub(super) fn check(ty: MessageType, text: &str) -> Result<(), String> {
    let theirs = fields(ty.name(), text)?;
    let ours = fields(ty.name(), &ty.definition())?;
    if theirs == ours {
        return Ok(());
    }
    let differs = theirs.iter().zip(&ours).find(|(a, b)| a != b);
    Err(match differs {
        Some((theirs, ours)) => {
            format!("its definition in the file has `{theirs}` where `{ours}` is expected")
        }
        None => format!(
            "its definition in the file has {} fields where {} are expected",
            theirs.len(),
            ours.len()
        ),
    })
}

/// Every primitive field of a definition in order, as `type path`.
fn fields(name: &str, text: &str) -> Result<Vec<String>, String> {
    if text.len() > TEXT_LIMIT {
        return Err("its definition is longer than 1 MiB".to_owned());
    }
    let schema = MessageSchema::parse(name, &text.replace("/msg/", "/"))
        .map_err(|error| format!("its definition cannot be parsed: {error:#}"))?;
    let mut found = Vec::new();
    let mut left = FIELD_LIMIT;
    flatten(&schema, &schema.spec, ("", 0), &mut left, &mut found)?;
    Ok(found)
}

/// `left` fields may still be visited, of whatever type: a type without one of its own can be nested as well.
fn flatten(
    schema: &MessageSchema,
    spec: &MessageSpecification,
    (prefix, depth): (&str, usize),
    left: &mut usize,
    found: &mut Vec<String>,
) -> Result<(), String> {
    const ENDLESS: &str = "its definition nests without end";
    if depth > DEPTH_LIMIT {
        return Err(ENDLESS.to_owned());
    }
    for field in &spec.fields {
        *left = left.checked_sub(1).ok_or(ENDLESS)?;
        let path = format!("{prefix}{}", field.name);
        let (element, suffix) = match &field.ty {
            Type::Array { ty, size } => (
                ty.as_ref(),
                match size {
                    ArraySize::Fixed(length) => format!("[{length}]"),
                    // A bound does not change the layout.
                    ArraySize::Bounded(_) | ArraySize::Unbounded => "[]".to_owned(),
                },
            ),
            other => (other, String::new()),
        };
        match element {
            Type::BuiltIn(primitive) => {
                found.push(format!("{}{suffix} {path}", layout_name(primitive)));
            }
            Type::Complex(complex) => {
                let nested = resolve(schema, spec, complex)?;
                let inner = (&*format!("{path}{suffix}."), depth + 1);
                flatten(schema, nested, inner, left, found)?;
            }
            Type::Array { .. } => return Err("it has arrays of arrays".to_owned()),
        }
    }
    Ok(())
}

/// A primitive's name, the same for those of the same layout.
fn layout_name(primitive: &BuiltInType) -> String {
    match primitive {
        BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => "uint8".to_owned(),
        BuiltInType::String(_) => "string".to_owned(),
        BuiltInType::WString(_) => "wstring".to_owned(),
        other => format!("{other:?}").to_lowercase(),
    }
}

/// A relative name means the package of the message that uses it.
fn resolve<'a>(
    schema: &'a MessageSchema,
    user: &MessageSpecification,
    complex: &ComplexType,
) -> Result<&'a MessageSpecification, String> {
    let wanted = match complex {
        ComplexType::Absolute { package, name } => format!("{package}/{name}"),
        // ROS 1 wrote it without its package.
        ComplexType::Relative { name } if name == "Header" => "std_msgs/Header".to_owned(),
        ComplexType::Relative { name } => {
            let package = user.name.split('/').next().unwrap_or_default();
            format!("{package}/{name}")
        }
    };
    schema
        .dependencies
        .iter()
        .find(|spec| spec.name == wanted)
        .ok_or_else(|| format!("its definition uses {wanted} and does not define it"))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    const EVERY: [MessageType; 6] = [
        MessageType::Image,
        MessageType::CompressedImage,
        MessageType::Wrench,
        MessageType::Pose,
        MessageType::Twist,
        MessageType::Point,
    ];

    #[test]
    fn our_own_definitions_pass() {
        for ty in EVERY {
            assert_eq!(check(ty, &ty.definition()), Ok(()), "{}", ty.name());
        }
    }

    #[test]
    fn spelling_does_not_matter_but_layout_does() {
        let text = MessageType::Wrench.definition();
        let spelled = text
            .replace("geometry_msgs/Vector3 force", "Vector3 force # newtons")
            .replace("MSG: geometry_msgs/", "MSG: geometry_msgs/msg/");
        assert_eq!(check(MessageType::Wrench, &spelled), Ok(()));
        let single = text.replace("float64 y", "float32 y");
        let said = check(MessageType::Wrench, &single).unwrap_err();
        assert!(said.contains("float32 wrench.force.y"), "{said}");
    }

    #[test]
    fn a_type_that_contains_itself_is_refused() {
        let text = "Loop next\n===\nMSG: geometry_msgs/Loop\nLoop next\n";
        let said = check(MessageType::Point, text).unwrap_err();
        assert!(said.contains("without end"), "{said}");
        // Nor is there an end to wait for where types without a field are nested, 40 to the power of 12 of them.
        let mut types = vec!["A0 next".to_owned()];
        for depth in 0..12 {
            types.push(format!("===\nMSG: geometry_msgs/A{depth}"));
            types.extend((0..40).map(|i| format!("A{} f{i}", depth + 1)));
        }
        types.push("===\nMSG: geometry_msgs/A12\nuint8 A=1\n".to_owned());
        let said = check(MessageType::Point, &types.join("\n")).unwrap_err();
        assert!(said.contains("without end"), "{said}");
    }
}
